"""Claims about what is neither offline nor online theory: figures, tables, environments, embeddings, algorithms."""
