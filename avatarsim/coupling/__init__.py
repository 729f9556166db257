"""Virtual coupling (eq. 6) of tracker and driven body: what impacts and pressing leave between them, how joints yield."""
