"""The commands of `workbench`, one small module each: `Args` and `run(args)`."""
