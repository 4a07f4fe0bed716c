"""The 3D view of a run, on viser. A package imports only packages above it in this list.

base/        address, setting, flights, axes and colours, shared by all other packages
live/        simulations on demand, in a child process
drawing/     the objects of a scene, and its cameras
panel/       the tabs of the viewer's panel
viewer/      one viewer: scene and panel of one browser socket
control/     connects a browser to its viewer, and lets the page control it
recordings/  a flight as a self-contained page that plays without a server
"""
