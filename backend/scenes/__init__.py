"""The 3D view of a run, on viser. Start reading at `viewer/viewer.py`. A room imports only rooms above it in this list.

base/        address, setting, flights, axes and colours, which all other rooms need
live/        simulations on demand, in a child process
drawing/     what stands and flies in a scene, and from where it is seen
panel/       the tabs of the viewer's panel and what they show
cloud/       the parameter space in place of the flights
viewer/      one viewer: scene and panel of one browser socket
control/     how a browser comes to its viewer, and how the page steers it
recordings/  a flight as a page that plays without a server
"""
