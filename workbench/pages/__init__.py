"""The pages, one module each: `page(context)` returns what Panel shows."""
