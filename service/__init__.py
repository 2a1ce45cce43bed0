"""The service: HTTP and WebSocket, conductor, database, sign-in, DICOM receiver, command line."""
