"""One table of how postures are shown: our presets beside other engines, on catalogue, drawn motions and clips that are given."""
