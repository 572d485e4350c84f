"""Routers of the REST contract, one file a subject. A route is one sentence: check, call one thing, answer."""
