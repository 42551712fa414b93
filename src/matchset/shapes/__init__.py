"""What is looked for: outlines in the image plane."""
