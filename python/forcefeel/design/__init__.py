"""What the 1974 report computed, for any loader: gains, boundary, responses, sensitivity, what to conclude."""
