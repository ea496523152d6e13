"""Values only: results, sensitivities, their variables and verdicts. Nothing here computes."""
