"""The objects of a scene, and its cameras."""
