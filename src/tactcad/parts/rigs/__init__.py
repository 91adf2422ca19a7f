"""The rigs around the array: cart, sample holder, stand, and what calibration and grasping add to them."""
