"""Every bound of the BRIDGE paper (arXiv 2509.26605): symbolic, numeric, certified. Pure mathematics."""
