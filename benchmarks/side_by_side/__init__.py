"""Other ways to do what Coaxial does, on the same images and in the same simulated room."""
