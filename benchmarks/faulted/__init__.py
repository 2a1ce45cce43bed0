"""Scenes with one thing wrong each, by the ten thousand: how many are accepted and wrong."""
