"""What stands and flies in a scene, and from where it is seen."""
