"""Crowds of equal balls with exact truth: who keeps which name?

Read `scenes` (juggling, billiards, a swarm), then `score` (HOTA, IDF1, switches of identities) and `__main__`.
"""
