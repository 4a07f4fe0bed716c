"""What may change a number: a change to a file of this folder is another code digest of runs."""
