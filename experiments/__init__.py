"""The paper's figures and tables: configurations, reproduction, comparison. The highest room of the house."""
