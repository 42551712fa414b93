"""Where pixels come from and what they mean."""
