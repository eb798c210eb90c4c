"""The Auto Diffusion Function and its prominent maxima."""
