"""One viewer: the scene and the panel of one browser socket, put together from their parts."""
