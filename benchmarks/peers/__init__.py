"""Other ways to solve the nonlinear case of `case`, each tuned to the fastest setting that meets its error."""
