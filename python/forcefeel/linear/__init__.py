"""The linear models and what they show: modes, frequency responses, margins, time responses, stability boundary."""
