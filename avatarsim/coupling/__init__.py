"""Virtual coupling (eq. 6) of tracker and driven body: the lag that impacts and pressing leave between them, how joints yield."""
