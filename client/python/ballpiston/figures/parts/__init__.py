"""What the figures share: tables, questions, the style of the pictures, outlines of the cell."""
