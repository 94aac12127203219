"""The online half of the ledger: one module a topic, its checks beside it in ``checks``."""
