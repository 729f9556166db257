"""Event-driven rigid-body simulation (Mirtich 1996; Schmidl and Lin 2004, eqs 7 to 10): the upper loop of Figure 3."""
