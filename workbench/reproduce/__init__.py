"""Table 4 and Fig. 8, 9, 12, 13 again: plan, runner, and the result sets that pages and documents draw from."""
