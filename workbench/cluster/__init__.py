"""The engine `ray`: runs as tasks of a Ray cluster. Nothing here is imported unless it is asked for."""
