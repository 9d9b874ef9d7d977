-- Whether it is time that somebody looks for what is due: always. A look costs little where few processes share a file.
-- ?1 how long nobody need look after somebody has [ms].
SELECT ?1 >= 0
