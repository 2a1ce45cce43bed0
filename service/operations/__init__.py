"""What whoever runs the service looks at: health, metrics, the doctor."""
