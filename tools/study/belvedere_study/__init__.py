"""Both user experiments of the papers as a page without a server, and what its answers say."""

__all__ = ["analysis", "order", "page", "records", "simulate", "stimuli"]
