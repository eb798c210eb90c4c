"""The main job and distances from a selection; finds the reference form and the pose to take."""
