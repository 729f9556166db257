"""The two loops of the paper's Figure 3, where the rooms meet: driven bodies first, then simulated ones."""
