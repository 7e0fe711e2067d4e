"""QGIS plugin: a Processing provider over the belvedere program."""


def classFactory(iface):
    """Called by QGIS when the plugin is loaded."""
    from .plugin import Plugin

    return Plugin(iface)
