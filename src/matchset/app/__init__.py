"""The live system: the command line, drawing, recording and reports; the only place that draws or prints."""
