"""What simulators declare: descriptors, functions, FMUs; parameters, results, columns, scenes."""
