"""What a person sees: figures, 3-D scenes and recordings made from flights. No I/O, no state."""
