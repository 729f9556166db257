"""Table 2 and Figure 8 of the paper, made again from a run: work per frame, shares of the frame, falling spikes."""
