"""What drives a loader: recursion (22) and its gain schedule, sampled laws and their designs."""
