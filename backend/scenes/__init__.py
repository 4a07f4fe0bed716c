"""The 3D view of a run, on viser. Start reading at `viewer`.

control/     how a browser comes to its viewer, how the page steers it, and who flies for it
drawing/     what stands and flies in a scene, and from where it is seen
panel/       the viewer's panel: its tabs and what they show
cloud/       the parameter space in place of the flights
recordings/  a flight as a page that plays without a server
"""
