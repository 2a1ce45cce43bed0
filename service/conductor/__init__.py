"""The conductor: everything between a command over HTTP and the outside world, one small file per command or group."""
