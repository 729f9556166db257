"""Time and error of one signed-distance query: avatarsim, coal, fcl, MuJoCo and PyBullet on the same pairs of shapes."""
