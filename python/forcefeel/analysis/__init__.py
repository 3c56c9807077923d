"""What the linear models say: modes, frequency responses, margins, time responses, stability boundary."""
