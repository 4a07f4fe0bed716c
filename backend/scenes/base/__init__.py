"""What every other room of the 3D view needs: its address, the run's setting, flights, axes, colours, and parts."""
