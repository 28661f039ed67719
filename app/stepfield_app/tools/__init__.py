"""What takes the mouse in a view before the camera does."""
