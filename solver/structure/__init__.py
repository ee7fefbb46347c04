"""Bottom-fixed elastic platform: a frame of 3-D Euler-Bernoulli beams."""
