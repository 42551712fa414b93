"""The paper's algorithm: match-set, fit, tracking, detection."""
